// Generated from web/src by web/tools/build.js: do not edit.
var M=class extends Error{constructor(r,t){super(`${r}: ${t}`);this.where=r;this.reason=t;this.name="WalkError"}};function N(f,e){return f instanceof M?f:new M(e,f instanceof Error?f.message:String(f))}var P=`#version 300 es
void main() {
  gl_Position = vec4(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID >> 1) * 4) - 1.0, 0.0,
                     1.0);
}
`;function D(f,e,r,t){let i=f.createProgram();if(!i)throw new Error(`${e}: the WebGL context is lost`);for(let[o,a]of[[f.VERTEX_SHADER,r],[f.FRAGMENT_SHADER,t]]){let s=f.createShader(o);if(!s)throw new Error(`${e}: the WebGL context is lost`);f.shaderSource(s,a),f.compileShader(s),f.attachShader(i,s),f.deleteShader(s)}if(f.linkProgram(i),!f.getProgramParameter(i,f.LINK_STATUS)&&!f.isContextLost()){let o=(f.getAttachedShaders(i)??[]).map(a=>f.getShaderInfoLog(a));throw new Error(`${e}: ${[f.getProgramInfoLog(i),...o].join(" ").trim()}`)}return i}function z(f,e){let r=f.worldFromEye,t=f.clipFromEye;for(let i=0;i<3;++i)for(let o=0;o<4;++o)e[4*i+o]=t[o]*r[i]+t[4+o]*r[4+i]+t[8+o]*r[8+i];for(let i=0;i<4;++i)e[12+i]=t[12+i]}async function G(f,e,r,t){let i={premultiplyAlpha:"premultiply",colorSpaceConversion:"none"},o=await createImageBitmap(new Blob([f],{type:"image/webp"}),i).catch(()=>{throw new M(e.name,"is no WebP picture that this browser reads")});if(o.width!==r||o.height!==t)throw o.close(),new M(e.name,`is not ${r} x ${t} texels large`);return o}var O=`#version 300 es
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
`;var Q=16,U=6,C=f=>Math.ceil(f/Q);var S=f=>Math.floor(f/64)*64,u=(f,e)=>f[0]*e[0]+f[1]*e[1]+f[2]*e[2],L=class{constructor(e,r){this.of=e;this.set=r;this.k1=0;this.k2=0;this.k3=0;this.leastCode=0;this.resolution=1;this.all=new Int32Array(4);this.shown=new Int32Array(4);this.g=new Float64Array(3);this.a=new Float64Array(3);this.b=new Float64Array(3);this.forward=new Float64Array(3);this.zNear=1;this.zFar=2;this.planeZ=1;this.widest=1;this.origin=new Float64Array(3);this.ray=new Float64Array(3);this.polygon=new Float64Array(12);this.centre=new Float64Array(3);this.ga=0;this.gb=0;let t=e.worldFromEye,i=(e.right-e.left)/e.width,o=(e.bottom-e.top)/e.height,a=e.perspective?0:e.planeZ,s=e.perspective?0:1;for(let h=0;h<3;++h){let l=e.left*t[h]+e.top*t[4+h];this.a[h]=t[h]*i,this.b[h]=t[4+h]*o,this.forward[h]=-t[8+h],this.origin[h]=t[12+h]-t[8+h]*a+l*s,this.g[h]=-t[8+h]+l}let n=1/0,c=-1/0;for(let h=0;h<3;++h){for(let l of e.hull)n=Math.min(n,l[h]),c=Math.max(c,l[h]);this.centre[h]=.5*(n+c),n=1/0,c=-1/0}}d(e){return this.of.first+e*this.of.step}magnified(e){return 1/(1+this.k3*e)}get least(){return this.k3>0?(1/64-1)/this.k3:-1/0}place(e,r,t){let{of:i,set:o,origin:a,a:s,b:n,g:c,forward:h,all:l,ray:d}=this;d[0]=a[0]-e,d[1]=a[1]-r,d[2]=a[2]-t;let m=u(d,h);if(i.perspective)this.k3=-m||1e-30,this.k1=(-u(d,s)-this.k3*u(c,s))/u(s,s),this.k2=(-u(d,n)-this.k3*u(c,n))/u(n,n);else{if(!(m>0))return!1;c.set(d),this.k3=1/m,this.k1=-this.k3*u(d,s)/u(s,s),this.k2=-this.k3*u(d,n)/u(n,n)}this.ga=u(c,s)/u(s,s),this.gb=u(c,n)/u(n,n);let{k1:g,k2:F}=this;this.leastCode=Math.max(0,Math.min(65535,Math.ceil((this.least-i.first)/i.step)));let w=this.d(this.leastCode),y=Math.max(0,.5*(o.splat-1)),x=1/0,E=1/0,A=-1/0,p=-1/0,k=-1/0,R=0;for(let v=0;v<i.hull.length;++v){let b=i.hull[v],T=Math.max(b[2],w),_=this.magnified(T);k=Math.max(k,b[2]),R=Math.max(R,_),x=Math.min(x,_*(b[0]+g*T-y)),E=Math.min(E,_*(b[1]+F*T-y)),A=Math.max(A,_*(b[0]+g*T+y)),p=Math.max(p,_*(b[1]+F*T+y))}if(!(k>=w))return!1;for(this.resolution=o.resolution;Math.max(A-x,p-E)*this.resolution>o.maxSize-2;)this.resolution*=.5;return l[0]=Math.floor(x*this.resolution),l[1]=Math.floor(E*this.resolution),l[2]=Math.max(l[0]+1,Math.ceil(A*this.resolution)),l[3]=Math.max(l[1]+1,Math.ceil(p*this.resolution)),this.widest=o.splat*this.resolution*R,this.placeDepths(m,w),!0}placeDepths(e,r){let{of:t}=this,i=this.d(65534);t.perspective?(this.zNear=(1-1e-5)*-(1+this.k3*r)/r,this.zFar=(1+1e-5)*-(1+this.k3*i)/i,this.planeZ=2*this.zNear*this.zFar/(this.zNear+this.zFar)):(this.planeZ=e,this.zNear=e+r-t.step,this.zFar=e+i+t.step)}show(e){let{all:r,shown:t,polygon:i,ray:o,a,b:s,g:n,forward:c,resolution:h}=this,l=e.worldFromEye,d=e.clipFromEye,m=u(n,c),g=u(a,a),F=u(s,s);for(let p=0;p<4;++p){let k=((p===1||p===2?1:-1)+d[8])/d[0],R=((p>1?1:-1)+d[9])/d[5];for(let b=0;b<3;++b)o[b]=l[b]*k+l[4+b]*R-l[8+b];let v=u(o,c)/m;i[3*p]=(u(o,a)/g-v*this.ga)*h,i[3*p+1]=(u(o,s)/F-v*this.gb)*h,i[3*p+2]=v}let w=1/0,y=1/0,x=-1/0,E=-1/0,A=1e-4/m;for(let p=0;p<4;++p){let k=3*p,R=(k+3)%12,v=i[k+2],b=i[R+2];for(let T=0;T<2;++T){let _=0;if(T===0?v<A:v<A==b<A)continue;T===1&&(_=(A-v)/(b-v));let V=v+_*(b-v),W=(i[k]+_*(i[R]-i[k]))/V,B=(i[k+1]+_*(i[R+1]-i[k+1]))/V;w=Math.min(w,W),y=Math.min(y,B),x=Math.max(x,W),E=Math.max(E,B)}}return t[0]=Math.max(r[0],S(Math.max(w,r[0]))),t[1]=Math.max(r[1],S(Math.max(y,r[1]))),t[2]=Math.min(r[2],S(Math.min(x,r[2]))+64),t[3]=Math.min(r[3],S(Math.min(E,r[3]))+64),t[2]>t[0]&&t[3]>t[1]}level(e){let r=Math.sqrt(u(this.a,this.a))/this.resolution/u(this.g,this.forward),t=.5*e.width*Math.abs(e.clipFromEye[0])*r,i=0;for(;i<8&&2*t<=.75;++i)t*=2;return i}get pinholeStep(){let{zNear:e,zFar:r,planeZ:t}=this,i=Math.sqrt(u(this.a,this.a))/this.resolution/u(this.g,this.forward),o=65534*r*e/((r-e)*t*t);return Math.max(1,Math.min(65535,Math.ceil(3*t*i*o)))}coefficients(e){let{of:r,k1:t,k2:i,k3:o,resolution:a,zNear:s}=this,n=65534*this.zFar/(this.zFar-s),c=r.first,h=r.step;e[0]=a*(.5+t*c),e[1]=a*t*h,e[2]=a*(.5+i*c),e[3]=a*i*h,e[4]=1+o*c,e[5]=o*h,e[6]=a,e[7]=a*this.set.splat,r.perspective?(e[8]=n*(1+(o+s)*c),e[9]=n*(o+s)*h,e[10]=e[4],e[11]=e[5]):(e[8]=n*(1/o+c-s),e[9]=n*h,e[10]=1/o+c,e[11]=h)}facing(e,r,t){let{of:i,origin:o,a,b:s,centre:n}=this;for(let l=0;l<i.hull.length;++l)if(!(i.hull[l][2]>=this.least))return-1;let c=0,h=0;for(let l=0;l<3;++l){let d=n[0]*a[l]+n[1]*s[l],m=i.perspective?o[l]-(this.g[l]+d)/n[2]:o[l]+d+n[2]*this.forward[l],g=(l===0?e:l===1?r:t)-m;c-=g*this.forward[l],h+=g*g}return 2+c/Math.sqrt(h)}along(e,r,t){let{set:{center:i},forward:o}=this;return o[0]*(i[0]-e)+o[1]*(i[1]-r)+o[2]*(i[2]-t)}isSure(e,r,t){if(this.of.perspective)return!1;let{set:{low:i,high:o},forward:a}=this,n=4*(.5*Math.hypot(o[0]-i[0],o[1]-i[1],o[2]-i[2]))/32767,c=a[0]*(this.origin[0]-e)+a[1]*(this.origin[1]-r)+a[2]*(this.origin[2]-t),h=-n;for(let l=0;l<3;++l){let d=l===0?e:l===1?r:t;h+=Math.min(a[l]*(i[l]-d),a[l]*(o[l]-d))}return c>n&&h>1.01*(c+n)/64}};var ee=["warp","frame","order","limits","place","clip_from_local","forward_near","corner","right","down"],te=new Uint32Array([65535,0,0,0]),re=new Float32Array(4),ie=new Float32Array([1]),Z=256,J=class{constructor(e,r,t,i){this.gl=e;this.decoder=t;this.host=i;this.stats={drawCalls:0,triangles:0,there:0};this.targets=[];this.depth=null;this.splatBuffer=null;this.width=0;this.height=0;this.clip=new Float32Array(16);this.coefficients=new Float32Array(12);this.shown=-1;this.result=null;this.level=0;this.wide=0;this.high=0;this.frame=0;this.best=-1;this.used=0;this.disposed=!1;this.slots=r.list.map(o=>({warp:new L(o,r),bytes:4*o.sheetWidth*o.sheetHeight+2*U*o.samples,coming:!1,failed:!1,lastUsed:0,next:null,stored:null})),this.splat=this.link("splats",O,H),this.pinhole=this.link("pinholes",P,j),this.halve=this.link("halves",P,q),this.board=this.link("relief",K,Y),this.noVertices=e.createVertexArray()}get bytes(){return this.used+16*this.width*this.height}get allFailed(){return this.slots.every(e=>e.failed)}get settled(){return this.best<0||this.slots[this.best].stored!==null||this.slots[this.best].failed}update(e,r,t){++this.frame,this.best=this.pick(e,r,t,!1),this.upload();let i=0;for(let o of this.slots)(o.coming||o.next)&&++i;this.best>=0&&this.want(this.best,!0);for(let o=0;o<this.slots.length&&i<1;++o)this.want(o,!1)&&++i}prepare(e){let{gl:r,stats:t,slots:i}=this,o=e.worldFromEye;if(t.drawCalls=t.triangles=0,this.shown=this.pick(o[12],o[13],o[14],!0),this.shown<0)return;let{warp:a,stored:s}=i[this.shown];if(i[this.shown].lastUsed=this.frame,!s||!a.place(o[12],o[13],o[14])||!a.show(e)){this.shown=-1;return}let n=Math.min(64,Math.ceil(.5*a.widest)+1),c=a.shown[0],h=a.shown[1];this.wide=a.shown[2]-c,this.high=a.shown[3]-h,this.makeTargets(this.wide+2*n,this.high+2*n),r.disable(r.SCISSOR_TEST),r.disable(r.BLEND),r.disable(r.STENCIL_TEST),r.disable(r.CULL_FACE),r.colorMask(!0,!0,!0,!0),this.drawSplats(a,s,c-n,h-n,this.wide+2*n,this.high+2*n),r.disable(r.DEPTH_TEST),r.bindVertexArray(this.noVertices),r.useProgram(this.pinhole.program),r.uniform4i(this.pinhole.at.place,n,n,a.pinholeStep,0),this.pass(0,1,this.wide,this.high),this.level=a.level(e);let l=1;for(let d=0;d<this.level;++d,l=1-l)r.useProgram(this.halve.program),r.uniform4i(this.halve.at.place,this.wide,this.high,0,0),this.wide=this.wide+1>>1,this.high=this.high+1>>1,this.pass(l,1-l,this.wide,this.high);r.bindVertexArray(null),this.result=this.targets[l]}draw(e,r){let{gl:t,stats:i,result:o}=this;if(this.shown<0||!o)return;let{warp:a}=this.slots[this.shown],{at:s,program:n}=this.board,c=e.worldFromEye,h=a.resolution,{a:l,b:d,g:m,forward:g,shown:F}=a;z(e,this.clip),t.useProgram(n),t.uniformMatrix4fv(s.clip_from_local,!1,this.clip),t.uniform4f(s.forward_near,-c[8],-c[9],-c[10],r);let w=F[0]/h,y=F[1]/h;t.uniform4f(s.corner,m[0]+w*l[0]+y*d[0],m[1]+w*l[1]+y*d[1],m[2]+w*l[2]+y*d[2],m[0]*g[0]+m[1]*g[1]+m[2]*g[2]);let x=(this.wide<<this.level)/h,E=(this.high<<this.level)/h;t.uniform4f(s.right,x*l[0],x*l[1],x*l[2],this.wide),t.uniform4f(s.down,E*d[0],E*d[1],E*d[2],this.high),t.uniform4f(s.place,this.wide,this.high,a.zNear,a.zFar),this.bind(o),t.bindVertexArray(this.noVertices),t.drawArrays(t.TRIANGLE_STRIP,0,4),t.bindVertexArray(null),++i.drawCalls,i.triangles+=2}dispose(){let{gl:e}=this;this.disposed=!0;for(let r of this.slots)r.next?.colors.close(),this.drop(r);this.dropTargets();for(let r of[this.splat,this.pinhole,this.halve,this.board])e.deleteProgram(r.program);e.deleteVertexArray(this.noVertices)}link(e,r,t){let{gl:i}=this,o=D(i,e,r,t);return i.useProgram(o),i.uniform1i(i.getUniformLocation(o,"codes"),1),{program:o,at:Object.fromEntries(ee.map(a=>[a,i.getUniformLocation(o,a)]))}}pick(e,r,t,i){let o=-1,a=-1/0;for(let s=0;s<this.slots.length;++s){let{warp:n,stored:c,failed:h}=this.slots[s];if((i?!c:h)||!n.place(e,r,t))continue;let l=n.isSure(e,r,t),d=n.facing(e,r,t),m=l?8+n.along(e,r,t):d>=0?4+d:-s;m<=a||(a=m,o=s)}return o}want(e,r){let t=this.slots[e];if(t.stored||t.coming||t.failed||t.next)return!1;for(;this.used+t.bytes>this.host.budget;){let i=null;for(let o of this.slots)o.stored&&(!i||o.lastUsed<i.lastUsed)&&(i=o);if(!r)return!1;if(!i)break;this.drop(i)}return t.coming=!0,this.used+=t.bytes,this.load(e),!0}drop(e){let{gl:r}=this;e.stored&&(r.deleteVertexArray(e.stored.vertices),r.deleteBuffer(e.stored.buffer),r.deleteTexture(e.stored.sheet),e.stored=null,this.used-=e.bytes,--this.stats.there)}async load(e){let r=this.slots[e],{of:t}=r.warp,i=null;try{let o=Promise.all([t.layers,t.codes].map(n=>this.host.fetch(n))).then(async([n,c])=>this.decoder.samples(c,t.codes.name,t,await this.decoder.plane16(n,t.layers,C(t.width),C(t.height)))),a=this.host.fetch(t.colors).then(async n=>{i=await G(await this.decoder.check(n,t.colors),t.colors,t.sheetWidth,t.sheetHeight)}),[s]=await Promise.all([o,a]);if(this.disposed)throw new M("walk","was disposed of");r.next={samples:s,colors:i},this.host.arrived()}catch(o){if(i?.close(),this.disposed)return;r.failed=!0,this.used-=r.bytes,this.host.failed(N(o,`relief ${e}`))}finally{r.coming=!1}}upload(){let{gl:e}=this,r=0;for(;r<this.slots.length&&!this.slots[r].next;)++r;if(r===this.slots.length)return;let t=this.slots[r],{samples:i,colors:o}=t.next;t.next=null;let a=I(e,e.RGBA8,o.width,o.height);e.pixelStorei(e.UNPACK_FLIP_Y_WEBGL,!1),e.pixelStorei(e.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),e.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,e.NONE),e.texSubImage2D(e.TEXTURE_2D,0,0,0,e.RGBA,e.UNSIGNED_BYTE,o),e.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,e.BROWSER_DEFAULT_WEBGL),e.bindTexture(e.TEXTURE_2D,null),o.close();let s=e.createVertexArray(),n=e.createBuffer();e.bindVertexArray(s),e.bindBuffer(e.ARRAY_BUFFER,n),e.bufferData(e.ARRAY_BUFFER,i,e.STATIC_DRAW);for(let[c,h,l]of[[0,4,0],[1,2,4]])e.enableVertexAttribArray(c),e.vertexAttribIPointer(c,h,e.UNSIGNED_SHORT,2*U,2*l);e.bindVertexArray(null),t.stored={vertices:s,buffer:n,sheet:a},++this.stats.there,this.host.loaded(r)}drawSplats(e,r,t,i,o,a){let{gl:s,stats:n}=this,{of:c,k1:h,k2:l,k3:d}=e,{at:m}=this.splat;s.bindFramebuffer(s.FRAMEBUFFER,this.splatBuffer),s.viewport(0,0,o,a),s.enable(s.DEPTH_TEST),s.depthFunc(s.LESS),s.depthMask(!0),s.clearBufferfv(s.COLOR,0,re),s.clearBufferuiv(s.COLOR,1,te),s.clearBufferfv(s.DEPTH,0,ie),s.useProgram(this.splat.program),e.coefficients(this.coefficients),s.uniform4fv(m.warp,this.coefficients),s.uniform4f(m.frame,t,i,o,a);let g=Math.max(c.width,c.height)+2,F=Math.max(-1,Math.min(c.width,Math.floor(h/d))),w=Math.max(-1,Math.min(c.height,Math.floor(l/d)));s.uniform4i(m.order,F,w,g,d<0?1:0),s.uniform2i(m.limits,e.leastCode,Math.max(1,Math.min(64,Math.floor(1048576e3/((g+1)*g))))),s.activeTexture(s.TEXTURE0),s.bindTexture(s.TEXTURE_2D,r.sheet),s.bindVertexArray(r.vertices),s.drawArrays(s.POINTS,0,c.samples),++n.drawCalls,n.triangles+=c.samples}bind(e){let{gl:r}=this;r.activeTexture(r.TEXTURE1),r.bindTexture(r.TEXTURE_2D,e.code),r.activeTexture(r.TEXTURE0),r.bindTexture(r.TEXTURE_2D,e.color)}pass(e,r,t,i){let{gl:o}=this;o.bindFramebuffer(o.FRAMEBUFFER,this.targets[r].framebuffer),o.viewport(0,0,t,i),this.bind(this.targets[e]),o.drawArrays(o.TRIANGLES,0,3),++this.stats.drawCalls,++this.stats.triangles}makeTargets(e,r){if(e<=this.width&&r<=this.height)return;let{gl:t}=this,i=(s,n)=>Math.max(n,Math.ceil(s/Z)*Z),o=i(e,this.width),a=i(r,this.height);this.dropTargets();for(let s=0;s<2;++s){let n=I(t,t.RGBA8,o,a,t.LINEAR),c=I(t,t.R16UI,o,a);this.targets.push({color:n,code:c,framebuffer:this.framebuffer(n,c)})}this.splatBuffer=this.framebuffer(this.targets[0].color,this.targets[0].code),this.depth=t.createRenderbuffer(),t.bindRenderbuffer(t.RENDERBUFFER,this.depth),t.renderbufferStorage(t.RENDERBUFFER,t.DEPTH_COMPONENT32F,o,a),t.framebufferRenderbuffer(t.FRAMEBUFFER,t.DEPTH_ATTACHMENT,t.RENDERBUFFER,this.depth),t.bindTexture(t.TEXTURE_2D,null),this.width=o,this.height=a}framebuffer(e,r){let{gl:t}=this,i=t.createFramebuffer();return t.bindFramebuffer(t.FRAMEBUFFER,i),t.framebufferTexture2D(t.FRAMEBUFFER,t.COLOR_ATTACHMENT0,t.TEXTURE_2D,e,0),t.framebufferTexture2D(t.FRAMEBUFFER,t.COLOR_ATTACHMENT1,t.TEXTURE_2D,r,0),t.drawBuffers([t.COLOR_ATTACHMENT0,t.COLOR_ATTACHMENT1]),i}dropTargets(){let{gl:e}=this;for(let r of this.targets)e.deleteTexture(r.color),e.deleteTexture(r.code),e.deleteFramebuffer(r.framebuffer);this.targets=[],this.result=null,e.deleteFramebuffer(this.splatBuffer),e.deleteRenderbuffer(this.depth),this.width=this.height=0}};function I(f,e,r,t,i=f.NEAREST){let o=f.createTexture();f.bindTexture(f.TEXTURE_2D,o),f.texStorage2D(f.TEXTURE_2D,1,e,r,t);for(let a of[f.TEXTURE_MIN_FILTER,f.TEXTURE_MAG_FILTER])f.texParameteri(f.TEXTURE_2D,a,i);return o}export{J as ReliefSet};
