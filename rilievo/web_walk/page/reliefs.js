// Generated from web/src by web/tools/build.js: do not edit.
var M=class extends Error{constructor(r,t){super(`${r}: ${t}`);this.where=r;this.reason=t;this.name="WalkError"}};function N(f,e){return f instanceof M?f:new M(e,f instanceof Error?f.message:String(f))}var P=`#version 300 es
void main() {
  gl_Position = vec4(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID >> 1) * 4) - 1.0, 0.0,
                     1.0);
}
`;function D(f,e,r,t){let o=f.createProgram();if(!o)throw new Error(`${e}: the WebGL context is lost`);for(let[i,n]of[[f.VERTEX_SHADER,r],[f.FRAGMENT_SHADER,t]]){let s=f.createShader(i);if(!s)throw new Error(`${e}: the WebGL context is lost`);f.shaderSource(s,n),f.compileShader(s),f.attachShader(o,s),f.deleteShader(s)}if(f.linkProgram(o),!f.getProgramParameter(o,f.LINK_STATUS)&&!f.isContextLost()){let i=(f.getAttachedShaders(o)??[]).map(n=>f.getShaderInfoLog(n));throw new Error(`${e}: ${[f.getProgramInfoLog(o),...i].join(" ").trim()}`)}return o}function z(f,e){let r=f.worldFromEye,t=f.clipFromEye;for(let o=0;o<3;++o)for(let i=0;i<4;++i)e[4*o+i]=t[i]*r[o]+t[4+i]*r[4+o]+t[8+i]*r[8+o];for(let o=0;o<4;++o)e[12+o]=t[12+o]}async function G(f,e,r,t){let o={premultiplyAlpha:"premultiply",colorSpaceConversion:"none"},i=await createImageBitmap(new Blob([f],{type:"image/webp"}),o).catch(()=>{throw new M(e.name,"is no WebP picture that this browser reads")});if(i.width!==r||i.height!==t)throw i.close(),new M(e.name,`is not ${r} x ${t} texels large`);return i}var O=`#version 300 es
precision highp float;
precision highp int;
layout(location=0)in uvec4 place;
layout(location=1)in uvec2 texel;
uniform highp sampler2D sheet;
uniform vec4 warp[3];
uniform vec4 frame;
uniform ivec4 order;
uniform ivec2 limits;
flat out vec4 v_color;
flat out vec3 v_splat;
flat out uvec2 v_code_key;
void main(){
float code=float(place.z),w=warp[1].x + warp[1].y*code,s=warp[1].z;
vec2 at=(s*vec2(place.xy)+ warp[0].xz + warp[0].yw*code)/w - frame.xy;
float side=warp[1].w/w;
gl_Position=int(place.z)<limits.x?vec4(2.0,2.0,2.0,1.0)
:vec4(2.0*at/frame.zw - 1.0,0.0,1.0);
gl_PointSize=side + 0.25;
v_splat=vec3(at,0.5*side);
v_color=texelFetch(sheet,ivec2(texel),0);
ivec2 off=abs(ivec2(place.xy)- order.xy);
if(order.w !=0)off=order.z - off;
v_code_key=uvec2(
clamp(round((warp[2].x + warp[2].y*code)/(warp[2].z + warp[2].w*code)),0.0,65534.0),
(off.y*order.z + off.x)*limits.y + min(int(place.w),limits.y - 1));
}
`,H=`#version 300 es
precision highp float;
precision highp int;
flat in vec4 v_color;
flat in vec3 v_splat;
flat in uvec2 v_code_key;
layout(location=0)out vec4 out_color;
layout(location=1)out uvec4 out_code;
void main(){
vec2 off=gl_FragCoord.xy - v_splat.xy;
if(any(lessThan(off,vec2(-v_splat.z)))||any(greaterThanEqual(off,vec2(v_splat.z))))discard;
gl_FragDepth=uintBitsToFloat(v_code_key.y + 0x00800000u);
out_color=v_color;
out_code=uvec4(v_code_key.x,0u,0u,0u);
}
`,X=`#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D colors;
uniform highp usampler2D codes;
`,$=`${X}
layout(location=0)out vec4 out_color;
layout(location=1)out uvec4 out_code;
`,j=`${$}
uniform ivec4 place;
void main(){
ivec2 at=ivec2(gl_FragCoord.xy)+ place.xy,from=at;
int own=int(texelFetch(codes,at,0).r),nearer=0,farthest=-1;
for(int k=0;k<9;++k){
ivec2 beside=at + ivec2(k % 3,k/3)- 1;
int code=int(texelFetch(codes,beside,0).r);
if(own<=code + place.z)continue;
++nearer;
if(code<=farthest)continue;
farthest=code;
from=beside;
}
if(nearer<7)from=at;
out_color=texelFetch(colors,from,0);
out_code=texelFetch(codes,from,0);
}
`,q=`${$}
uniform ivec4 place;
void main(){
vec4 sum=vec4(0.0);
uint nearest=65535u;
for(int k=0;k<4;++k){
ivec2 at=2*ivec2(gl_FragCoord.xy)+ ivec2(k&1,k>>1);
if(any(greaterThanEqual(at,place.xy)))continue;
sum +=texelFetch(colors,at,0);
nearest=min(nearest,texelFetch(codes,at,0).r);
}
out_color=0.25*sum;
out_code=uvec4(nearest,0u,0u,0u);
}
`,K=`#version 300 es
precision highp float;
uniform mat4 clip_from_local;
uniform vec4 forward_near;
uniform vec4 corner;
uniform vec4 right,down;
out vec2 v_texel;
out float v_towards;
void main(){
vec2 at=vec2(gl_VertexID&1,gl_VertexID>>1);
vec3 p=corner.xyz + at.x*right.xyz + at.y*down.xyz;
gl_Position=clip_from_local*vec4(p,1.0);
gl_Position.z=0.0;
v_texel=at*vec2(right.w,down.w);
v_towards=dot(forward_near.xyz,p)/corner.w;
}
`,Y=`${X}
in vec2 v_texel;
in float v_towards;
uniform vec4 forward_near;
uniform vec4 place;
layout(location=0)out vec4 out_color;
void main(){
vec2 uv=clamp(v_texel,vec2(0.5),place.xy - 0.5);
vec4 color=texture(colors,uv/vec2(textureSize(colors,0)));
if(color.a<0.5)discard;
ivec2 at=ivec2(uv),last=ivec2(place.xy)- 1;
uint code=texelFetch(codes,at,0).r;
if(code==65535u)
for(int k=0;k<9;++k)
code=min(code,texelFetch(codes,clamp(at + ivec2(k % 3,k/3)- 1,ivec2(0),last),0).r);
float z=place.z*place.w/(place.w - float(code)/65534.0*(place.w - place.z));
gl_FragDepth=clamp(1.0 - forward_near.w/(z*v_towards),0.0,1.0);
out_color=vec4(color.rgb/color.a,1.0);
}
`;var Q=16,U=6,C=f=>Math.ceil(f/Q);var m=(f,e)=>f[0]*e[0]+f[1]*e[1]+f[2]*e[2],L=class{constructor(e,r){this.of=e;this.set=r;this.k1=0;this.k2=0;this.k3=0;this.leastCode=0;this.resolution=1;this.all=new Int32Array(4);this.shown=new Int32Array(4);this.g=new Float64Array(3);this.a=new Float64Array(3);this.b=new Float64Array(3);this.forward=new Float64Array(3);this.zNear=1;this.zFar=2;this.planeZ=1;this.widest=1;this.origin=new Float64Array(3);this.ray=new Float64Array(3);this.polygon=new Float64Array(12);this.centre=new Float64Array(3);this.ga=0;this.gb=0;let t=e.worldFromEye,o=(e.right-e.left)/e.width,i=(e.bottom-e.top)/e.height,n=e.perspective?0:e.planeZ,s=e.perspective?0:1;for(let h=0;h<3;++h){let l=e.left*t[h]+e.top*t[4+h];this.a[h]=t[h]*o,this.b[h]=t[4+h]*i,this.forward[h]=-t[8+h],this.origin[h]=t[12+h]-t[8+h]*n+l*s,this.g[h]=-t[8+h]+l}let a=1/0,c=-1/0;for(let h=0;h<3;++h){for(let l of e.hull)a=Math.min(a,l[h]),c=Math.max(c,l[h]);this.centre[h]=.5*(a+c),a=1/0,c=-1/0}}d(e){return this.of.first+e*this.of.step}magnified(e){return 1/(1+this.k3*e)}get least(){return this.k3>0?(1/64-1)/this.k3:-1/0}place(e,r,t){let{of:o,set:i,origin:n,a:s,b:a,g:c,forward:h,all:l,ray:d}=this;d[0]=n[0]-e,d[1]=n[1]-r,d[2]=n[2]-t;let u=m(d,h);if(o.perspective)this.k3=-u||1e-30,this.k1=(-m(d,s)-this.k3*m(c,s))/m(s,s),this.k2=(-m(d,a)-this.k3*m(c,a))/m(a,a);else{if(!(u>0))return!1;c.set(d),this.k3=1/u,this.k1=-this.k3*m(d,s)/m(s,s),this.k2=-this.k3*m(d,a)/m(a,a)}this.ga=m(c,s)/m(s,s),this.gb=m(c,a)/m(a,a);let{k1:p,k2:_}=this;this.leastCode=Math.max(0,Math.min(65535,Math.ceil((this.least-o.first)/o.step)));let y=this.d(this.leastCode),w=Math.max(0,.5*(i.splat-1)),x=1/0,E=1/0,F=-1/0,A=-1/0,b=-1/0,k=0;for(let R=0;R<o.hull.length;++R){let g=o.hull[R],v=Math.max(g[2],y),T=this.magnified(v);b=Math.max(b,g[2]),k=Math.max(k,T),x=Math.min(x,T*(g[0]+p*v-w)),E=Math.min(E,T*(g[1]+_*v-w)),F=Math.max(F,T*(g[0]+p*v+w)),A=Math.max(A,T*(g[1]+_*v+w))}if(!(b>=y))return!1;for(this.resolution=i.resolution;Math.max(F-x,A-E)*this.resolution>i.maxSize-2;)this.resolution*=.5;return l[0]=Math.floor(x*this.resolution),l[1]=Math.floor(E*this.resolution),l[2]=Math.max(l[0]+1,Math.ceil(F*this.resolution)),l[3]=Math.max(l[1]+1,Math.ceil(A*this.resolution)),this.widest=i.splat*this.resolution*k,this.placeDepths(u,y),!0}placeDepths(e,r){let{of:t}=this,o=this.d(65534);t.perspective?(this.zNear=(1-1e-5)*-(1+this.k3*r)/r,this.zFar=(1+1e-5)*-(1+this.k3*o)/o,this.planeZ=2*this.zNear*this.zFar/(this.zNear+this.zFar)):(this.planeZ=e,this.zNear=e+r-t.step,this.zFar=e+o+t.step)}show(e){let{all:r,shown:t,polygon:o,ray:i,a:n,b:s,g:a,forward:c,resolution:h}=this,l=e.worldFromEye,d=e.clipFromEye,u=m(a,c),p=m(n,n),_=m(s,s);for(let b=0;b<4;++b){let k=((b===1||b===2?1:-1)+d[8])/d[0],R=((b>1?1:-1)+d[9])/d[5];for(let v=0;v<3;++v)i[v]=l[v]*k+l[4+v]*R-l[8+v];let g=m(i,c)/u;o[3*b]=(m(i,n)/p-g*this.ga)*h,o[3*b+1]=(m(i,s)/_-g*this.gb)*h,o[3*b+2]=g}let y=1/0,w=1/0,x=-1/0,E=-1/0,F=1e-4/u;for(let b=0;b<4;++b){let k=3*b,R=(k+3)%12,g=o[k+2],v=o[R+2];for(let T=0;T<2;++T){let S=0;if(T===0?g<F:g<F==v<F)continue;T===1&&(S=(F-g)/(v-g));let V=g+S*(v-g),W=(o[k]+S*(o[R]-o[k]))/V,B=(o[k+1]+S*(o[R+1]-o[k+1]))/V;y=Math.min(y,W),w=Math.min(w,B),x=Math.max(x,W),E=Math.max(E,B)}}let A=b=>Math.floor(b/64)*64;return t[0]=Math.max(r[0],A(Math.max(y,r[0]))),t[1]=Math.max(r[1],A(Math.max(w,r[1]))),t[2]=Math.min(r[2],A(Math.min(x,r[2]))+64),t[3]=Math.min(r[3],A(Math.min(E,r[3]))+64),t[2]>t[0]&&t[3]>t[1]}level(e){let r=Math.sqrt(m(this.a,this.a))/this.resolution/m(this.g,this.forward),t=.5*e.width*Math.abs(e.clipFromEye[0])*r,o=0;for(;o<8&&2*t<=.75;++o)t*=2;return o}get pinholeStep(){let{zNear:e,zFar:r,planeZ:t}=this,o=Math.sqrt(m(this.a,this.a))/this.resolution/m(this.g,this.forward),i=65534*r*e/((r-e)*t*t);return Math.max(1,Math.min(65535,Math.ceil(3*t*o*i)))}coefficients(e){let{of:r,k1:t,k2:o,k3:i,resolution:n,zNear:s}=this,a=65534*this.zFar/(this.zFar-s),c=r.first,h=r.step;e[0]=n*(.5+t*c),e[1]=n*t*h,e[2]=n*(.5+o*c),e[3]=n*o*h,e[4]=1+i*c,e[5]=i*h,e[6]=n,e[7]=n*this.set.splat,r.perspective?(e[8]=a*(1+(i+s)*c),e[9]=a*(i+s)*h,e[10]=e[4],e[11]=e[5]):(e[8]=a*(1/i+c-s),e[9]=a*h,e[10]=1/i+c,e[11]=h)}facing(e,r,t){let{of:o,origin:i,a:n,b:s,centre:a}=this;for(let l=0;l<o.hull.length;++l)if(!(o.hull[l][2]>=this.least))return-1;let c=0,h=0;for(let l=0;l<3;++l){let d=a[0]*n[l]+a[1]*s[l],u=o.perspective?i[l]-(this.g[l]+d)/a[2]:i[l]+d+a[2]*this.forward[l],p=(l===0?e:l===1?r:t)-u;c-=p*this.forward[l],h+=p*p}return 2+c/Math.sqrt(h)}along(e,r,t){let{set:{center:o},forward:i}=this;return i[0]*(o[0]-e)+i[1]*(o[1]-r)+i[2]*(o[2]-t)}isSure(e,r,t){if(this.of.perspective)return!1;let{set:{low:o,high:i},forward:n}=this,a=4*(.5*Math.hypot(i[0]-o[0],i[1]-o[1],i[2]-o[2]))/32767,c=n[0]*(this.origin[0]-e)+n[1]*(this.origin[1]-r)+n[2]*(this.origin[2]-t),h=-a;for(let l=0;l<3;++l){let d=l===0?e:l===1?r:t;h+=Math.min(n[l]*(o[l]-d),n[l]*(i[l]-d))}return c>a&&h>1.01*(c+a)/64}};var ee=["warp","frame","order","limits","place","clip_from_local","forward_near","corner","right","down"],te=new Uint32Array([65535,0,0,0]),re=new Float32Array(4),oe=new Float32Array([1]),Z=256,J=class{constructor(e,r,t,o){this.gl=e;this.decoder=t;this.host=o;this.stats={drawCalls:0,triangles:0,there:0};this.targets=[];this.depth=null;this.splatBuffer=null;this.width=0;this.height=0;this.clip=new Float32Array(16);this.coefficients=new Float32Array(12);this.shown=-1;this.result=null;this.level=0;this.wide=0;this.high=0;this.frame=0;this.best=-1;this.used=0;this.disposed=!1;this.slots=r.list.map(i=>({warp:new L(i,r),bytes:4*i.sheetWidth*i.sheetHeight+2*U*i.samples,coming:!1,failed:!1,lastUsed:0,next:null,stored:null})),this.splat=this.link("splats",O,H),this.pinhole=this.link("pinholes",P,j),this.halve=this.link("halves",P,q),this.board=this.link("relief",K,Y),this.noVertices=e.createVertexArray()}get bytes(){return this.used+16*this.width*this.height}get allFailed(){return this.slots.every(e=>e.failed)}get settled(){return this.best<0||this.slots[this.best].stored!==null||this.slots[this.best].failed}update(e,r,t){++this.frame,this.best=this.pick(e,r,t,!1),this.upload();let o=0;for(let i of this.slots)(i.coming||i.next)&&++o;this.best>=0&&this.want(this.best,!0);for(let i=0;i<this.slots.length&&o<1;++i)this.want(i,!1)&&++o}prepare(e){let{gl:r,stats:t,slots:o}=this,i=e.worldFromEye;if(t.drawCalls=t.triangles=0,this.shown=this.pick(i[12],i[13],i[14],!0),this.shown<0)return;let{warp:n,stored:s}=o[this.shown];if(o[this.shown].lastUsed=this.frame,!s||!n.place(i[12],i[13],i[14])||!n.show(e)){this.shown=-1;return}let a=Math.min(64,Math.ceil(.5*n.widest)+1),[c,h,l,d]=n.shown;this.wide=l-c,this.high=d-h,this.makeTargets(this.wide+2*a,this.high+2*a);for(let p of[r.SCISSOR_TEST,r.BLEND,r.STENCIL_TEST,r.CULL_FACE])r.disable(p);r.colorMask(!0,!0,!0,!0),this.drawSplats(n,s,c-a,h-a,this.wide+2*a,this.high+2*a),r.disable(r.DEPTH_TEST),r.bindVertexArray(this.noVertices),r.useProgram(this.pinhole.program),r.uniform4i(this.pinhole.at.place,a,a,n.pinholeStep,0),this.pass(0,1,this.wide,this.high),this.level=n.level(e);let u=1;for(let p=0;p<this.level;++p,u=1-u)r.useProgram(this.halve.program),r.uniform4i(this.halve.at.place,this.wide,this.high,0,0),this.wide=this.wide+1>>1,this.high=this.high+1>>1,this.pass(u,1-u,this.wide,this.high);r.bindVertexArray(null),this.result=this.targets[u]}draw(e,r){let{gl:t,stats:o,result:i}=this;if(this.shown<0||!i)return;let{warp:n}=this.slots[this.shown],{at:s,program:a}=this.board,c=e.worldFromEye,h=n.resolution,{a:l,b:d,g:u,forward:p,shown:_}=n;z(e,this.clip),t.useProgram(a),t.uniformMatrix4fv(s.clip_from_local,!1,this.clip),t.uniform4f(s.forward_near,-c[8],-c[9],-c[10],r);let y=_[0]/h,w=_[1]/h;t.uniform4f(s.corner,u[0]+y*l[0]+w*d[0],u[1]+y*l[1]+w*d[1],u[2]+y*l[2]+w*d[2],u[0]*p[0]+u[1]*p[1]+u[2]*p[2]);let x=(this.wide<<this.level)/h,E=(this.high<<this.level)/h;t.uniform4f(s.right,x*l[0],x*l[1],x*l[2],this.wide),t.uniform4f(s.down,E*d[0],E*d[1],E*d[2],this.high),t.uniform4f(s.place,this.wide,this.high,n.zNear,n.zFar),this.bind(i),t.bindVertexArray(this.noVertices),t.drawArrays(t.TRIANGLE_STRIP,0,4),t.bindVertexArray(null),++o.drawCalls,o.triangles+=2}dispose(){let{gl:e}=this;this.disposed=!0;for(let r of this.slots)r.next?.colors.close(),this.drop(r);this.dropTargets();for(let r of[this.splat,this.pinhole,this.halve,this.board])e.deleteProgram(r.program);e.deleteVertexArray(this.noVertices)}link(e,r,t){let{gl:o}=this,i=D(o,e,r,t);return o.useProgram(i),o.uniform1i(o.getUniformLocation(i,"codes"),1),{program:i,at:Object.fromEntries(ee.map(n=>[n,o.getUniformLocation(i,n)]))}}pick(e,r,t,o){let i=-1,n=-1/0;for(let s=0;s<this.slots.length;++s){let{warp:a,stored:c,failed:h}=this.slots[s];if((o?!c:h)||!a.place(e,r,t))continue;let l=a.isSure(e,r,t),d=a.facing(e,r,t),u=l?8+a.along(e,r,t):d>=0?4+d:-s;u<=n||(n=u,i=s)}return i}want(e,r){let t=this.slots[e];if(t.stored||t.coming||t.failed||t.next)return!1;for(;this.used+t.bytes>this.host.budget;){let o=null;for(let i of this.slots)i.stored&&(!o||i.lastUsed<o.lastUsed)&&(o=i);if(!r)return!1;if(!o)break;this.drop(o)}return t.coming=!0,this.used+=t.bytes,this.load(e),!0}drop(e){let{gl:r}=this;e.stored&&(r.deleteVertexArray(e.stored.vertices),r.deleteBuffer(e.stored.buffer),r.deleteTexture(e.stored.sheet),e.stored=null,this.used-=e.bytes,--this.stats.there)}async load(e){let r=this.slots[e],{of:t}=r.warp,o=null;try{let i=Promise.all([t.layers,t.codes].map(a=>this.host.fetch(a))).then(async([a,c])=>this.decoder.samples(c,t.codes.name,t,await this.decoder.plane16(a,t.layers,C(t.width),C(t.height)))),n=this.host.fetch(t.colors).then(async a=>{o=await G(await this.decoder.check(a,t.colors),t.colors,t.sheetWidth,t.sheetHeight)}),[s]=await Promise.all([i,n]);if(this.disposed)throw new M("walk","was disposed of");r.next={samples:s,colors:o},this.host.arrived()}catch(i){if(o?.close(),this.disposed)return;r.failed=!0,this.used-=r.bytes,this.host.failed(N(i,`relief ${e}`))}finally{r.coming=!1}}upload(){let{gl:e}=this,r=this.slots.findIndex(c=>c.next);if(r<0)return;let t=this.slots[r],{samples:o,colors:i}=t.next;t.next=null;let n=I(e,e.RGBA8,i.width,i.height);e.pixelStorei(e.UNPACK_FLIP_Y_WEBGL,!1),e.pixelStorei(e.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),e.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,e.NONE),e.texSubImage2D(e.TEXTURE_2D,0,0,0,e.RGBA,e.UNSIGNED_BYTE,i),e.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,e.BROWSER_DEFAULT_WEBGL),e.bindTexture(e.TEXTURE_2D,null),i.close();let s=e.createVertexArray(),a=e.createBuffer();e.bindVertexArray(s),e.bindBuffer(e.ARRAY_BUFFER,a),e.bufferData(e.ARRAY_BUFFER,o,e.STATIC_DRAW);for(let[c,h,l]of[[0,4,0],[1,2,4]])e.enableVertexAttribArray(c),e.vertexAttribIPointer(c,h,e.UNSIGNED_SHORT,2*U,2*l);e.bindVertexArray(null),t.stored={vertices:s,buffer:a,sheet:n},++this.stats.there,this.host.loaded(r)}drawSplats(e,r,t,o,i,n){let{gl:s,stats:a}=this,{of:c,k1:h,k2:l,k3:d}=e,{at:u}=this.splat;s.bindFramebuffer(s.FRAMEBUFFER,this.splatBuffer),s.viewport(0,0,i,n),s.enable(s.DEPTH_TEST),s.depthFunc(s.LESS),s.depthMask(!0),s.clearBufferfv(s.COLOR,0,re),s.clearBufferuiv(s.COLOR,1,te),s.clearBufferfv(s.DEPTH,0,oe),s.useProgram(this.splat.program),e.coefficients(this.coefficients),s.uniform4fv(u.warp,this.coefficients),s.uniform4f(u.frame,t,o,i,n);let p=Math.max(c.width,c.height)+2,_=Math.max(-1,Math.min(c.width,Math.floor(h/d))),y=Math.max(-1,Math.min(c.height,Math.floor(l/d)));s.uniform4i(u.order,_,y,p,d<0?1:0),s.uniform2i(u.limits,e.leastCode,Math.max(1,Math.min(64,Math.floor(1048576e3/((p+1)*p))))),s.activeTexture(s.TEXTURE0),s.bindTexture(s.TEXTURE_2D,r.sheet),s.bindVertexArray(r.vertices),s.drawArrays(s.POINTS,0,c.samples),++a.drawCalls,a.triangles+=c.samples}bind(e){let{gl:r}=this;r.activeTexture(r.TEXTURE1),r.bindTexture(r.TEXTURE_2D,e.code),r.activeTexture(r.TEXTURE0),r.bindTexture(r.TEXTURE_2D,e.color)}pass(e,r,t,o){let{gl:i}=this;i.bindFramebuffer(i.FRAMEBUFFER,this.targets[r].framebuffer),i.viewport(0,0,t,o),this.bind(this.targets[e]),i.drawArrays(i.TRIANGLES,0,3),++this.stats.drawCalls,++this.stats.triangles}makeTargets(e,r){if(e<=this.width&&r<=this.height)return;let{gl:t}=this,o=(s,a)=>Math.max(a,Math.ceil(s/Z)*Z),i=o(e,this.width),n=o(r,this.height);this.dropTargets();for(let s=0;s<2;++s){let a=I(t,t.RGBA8,i,n,t.LINEAR),c=I(t,t.R16UI,i,n);this.targets.push({color:a,code:c,framebuffer:this.framebuffer(a,c)})}this.splatBuffer=this.framebuffer(this.targets[0].color,this.targets[0].code),this.depth=t.createRenderbuffer(),t.bindRenderbuffer(t.RENDERBUFFER,this.depth),t.renderbufferStorage(t.RENDERBUFFER,t.DEPTH_COMPONENT32F,i,n),t.framebufferRenderbuffer(t.FRAMEBUFFER,t.DEPTH_ATTACHMENT,t.RENDERBUFFER,this.depth),t.bindTexture(t.TEXTURE_2D,null),this.width=i,this.height=n}framebuffer(e,r){let{gl:t}=this,o=t.createFramebuffer();return t.bindFramebuffer(t.FRAMEBUFFER,o),t.framebufferTexture2D(t.FRAMEBUFFER,t.COLOR_ATTACHMENT0,t.TEXTURE_2D,e,0),t.framebufferTexture2D(t.FRAMEBUFFER,t.COLOR_ATTACHMENT1,t.TEXTURE_2D,r,0),t.drawBuffers([t.COLOR_ATTACHMENT0,t.COLOR_ATTACHMENT1]),o}dropTargets(){let{gl:e}=this;for(let r of this.targets)e.deleteTexture(r.color),e.deleteTexture(r.code),e.deleteFramebuffer(r.framebuffer);this.targets=[],this.result=null,e.deleteFramebuffer(this.splatBuffer),e.deleteRenderbuffer(this.depth),this.width=this.height=0}};function I(f,e,r,t,o=f.NEAREST){let i=f.createTexture();f.bindTexture(f.TEXTURE_2D,i),f.texStorage2D(f.TEXTURE_2D,1,e,r,t);for(let n of[f.TEXTURE_MIN_FILTER,f.TEXTURE_MAG_FILTER])f.texParameteri(f.TEXTURE_2D,n,o);return i}export{J as ReliefSet};
