// Generated from web/src by web/tools/build.js: do not edit.
var M=class extends Error{constructor(r,t){super(`${r}: ${t}`);this.where=r;this.reason=t;this.name="WalkError"}};function N(c,e){return c instanceof M?c:new M(e,c instanceof Error?c.message:String(c))}var P=`#version 300 es
void main() {
  gl_Position = vec4(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID >> 1) * 4) - 1.0, 0.0,
                     1.0);
}
`;function Q(c,e,r,t){let o=c.createProgram();if(!o)throw new Error(`${e}: the WebGL context is lost`);for(let[i,n]of[[c.VERTEX_SHADER,r],[c.FRAGMENT_SHADER,t]]){let s=c.createShader(i);if(!s)throw new Error(`${e}: the WebGL context is lost`);c.shaderSource(s,n),c.compileShader(s),c.attachShader(o,s),c.deleteShader(s)}return c.linkProgram(o),o}function ee(c,e,r){if(c.getProgramParameter(r,c.LINK_STATUS)||c.isContextLost())return;let t=(c.getAttachedShaders(r)??[]).map(o=>c.getShaderInfoLog(o));throw new Error(`${e}: ${[c.getProgramInfoLog(r),...t].join(" ").trim()}`)}function D(c,e,r,t){let o=Q(c,e,r,t);return ee(c,e,o),o}function G(c,e){let r=c.worldFromEye,t=c.clipFromEye;for(let o=0;o<3;++o)for(let i=0;i<4;++i)e[4*o+i]=t[i]*r[o]+t[4+i]*r[4+o]+t[8+i]*r[8+o];for(let o=0;o<4;++o)e[12+o]=t[12+o]}async function z(c,e,r,t){let o={premultiplyAlpha:"premultiply",colorSpaceConversion:"none"},i=await createImageBitmap(new Blob([c],{type:"image/webp"}),o).catch(()=>{throw new M(e.name,"is no WebP picture that this browser reads")});if(i.width!==r||i.height!==t)throw i.close(),new M(e.name,`is not ${r} x ${t} texels large`);return i}var O=`#version 300 es
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
`;var te=16,C=6,U=c=>Math.ceil(c/te);var S=c=>Math.floor(c/64)*64,u=(c,e)=>c[0]*e[0]+c[1]*e[1]+c[2]*e[2],L=class{constructor(e,r){this.of=e;this.set=r;this.k1=0;this.k2=0;this.k3=0;this.leastCode=0;this.resolution=1;this.all=new Int32Array(4);this.shown=new Int32Array(4);this.g=new Float64Array(3);this.a=new Float64Array(3);this.b=new Float64Array(3);this.forward=new Float64Array(3);this.zNear=1;this.zFar=2;this.planeZ=1;this.widest=1;this.origin=new Float64Array(3);this.ray=new Float64Array(3);this.polygon=new Float64Array(12);this.centre=new Float64Array(3);this.ga=0;this.gb=0;let t=e.worldFromEye,o=(e.right-e.left)/e.width,i=(e.bottom-e.top)/e.height,n=e.perspective?0:e.planeZ,s=e.perspective?0:1;for(let h=0;h<3;++h){let l=e.left*t[h]+e.top*t[4+h];this.a[h]=t[h]*o,this.b[h]=t[4+h]*i,this.forward[h]=-t[8+h],this.origin[h]=t[12+h]-t[8+h]*n+l*s,this.g[h]=-t[8+h]+l}let a=1/0,f=-1/0;for(let h=0;h<3;++h){for(let l of e.hull)a=Math.min(a,l[h]),f=Math.max(f,l[h]);this.centre[h]=.5*(a+f),a=1/0,f=-1/0}}d(e){return this.of.first+e*this.of.step}magnified(e){return 1/(1+this.k3*e)}get least(){return this.k3>0?(1/64-1)/this.k3:-1/0}place(e,r,t){let{of:o,set:i,origin:n,a:s,b:a,g:f,forward:h,all:l,ray:d}=this;d[0]=n[0]-e,d[1]=n[1]-r,d[2]=n[2]-t;let m=u(d,h);if(o.perspective)this.k3=-m||1e-30,this.k1=(-u(d,s)-this.k3*u(f,s))/u(s,s),this.k2=(-u(d,a)-this.k3*u(f,a))/u(a,a);else{if(!(m>0))return!1;f.set(d),this.k3=1/m,this.k1=-this.k3*u(d,s)/u(s,s),this.k2=-this.k3*u(d,a)/u(a,a)}this.ga=u(f,s)/u(s,s),this.gb=u(f,a)/u(a,a);let{k1:g,k2:F}=this;this.leastCode=Math.max(0,Math.min(65535,Math.ceil((this.least-o.first)/o.step)));let y=this.d(this.leastCode),w=Math.max(0,.5*(i.splat*o.splatScale-1)),x=1/0,E=1/0,A=-1/0,p=-1/0,k=-1/0,R=0;for(let v=0;v<o.hull.length;++v){let b=o.hull[v],T=Math.max(b[2],y),_=this.magnified(T);k=Math.max(k,b[2]),R=Math.max(R,_),x=Math.min(x,_*(b[0]+g*T-w)),E=Math.min(E,_*(b[1]+F*T-w)),A=Math.max(A,_*(b[0]+g*T+w)),p=Math.max(p,_*(b[1]+F*T+w))}if(!(k>=y))return!1;for(this.resolution=i.resolution;Math.max(A-x,p-E)*this.resolution>i.maxSize-2;)this.resolution*=.5;return l[0]=Math.floor(x*this.resolution),l[1]=Math.floor(E*this.resolution),l[2]=Math.max(l[0]+1,Math.ceil(A*this.resolution)),l[3]=Math.max(l[1]+1,Math.ceil(p*this.resolution)),this.widest=i.splat*o.splatScale*this.resolution*R,this.placeDepths(m,y),!0}placeDepths(e,r){let{of:t}=this,o=this.d(65534);t.perspective?(this.zNear=(1-1e-5)*-(1+this.k3*r)/r,this.zFar=(1+1e-5)*-(1+this.k3*o)/o,this.planeZ=2*this.zNear*this.zFar/(this.zNear+this.zFar)):(this.planeZ=e,this.zNear=e+r-t.step,this.zFar=e+o+t.step)}show(e){let{all:r,shown:t,polygon:o,ray:i,a:n,b:s,g:a,forward:f,resolution:h}=this,l=e.worldFromEye,d=e.clipFromEye,m=u(a,f),g=u(n,n),F=u(s,s);for(let p=0;p<4;++p){let k=((p===1||p===2?1:-1)+d[8])/d[0],R=((p>1?1:-1)+d[9])/d[5];for(let b=0;b<3;++b)i[b]=l[b]*k+l[4+b]*R-l[8+b];let v=u(i,f)/m;o[3*p]=(u(i,n)/g-v*this.ga)*h,o[3*p+1]=(u(i,s)/F-v*this.gb)*h,o[3*p+2]=v}let y=1/0,w=1/0,x=-1/0,E=-1/0,A=1e-4/m;for(let p=0;p<4;++p){let k=3*p,R=(k+3)%12,v=o[k+2],b=o[R+2];for(let T=0;T<2;++T){let _=0;if(T===0?v<A:v<A==b<A)continue;T===1&&(_=(A-v)/(b-v));let I=v+_*(b-v),V=(o[k]+_*(o[R]-o[k]))/I,B=(o[k+1]+_*(o[R+1]-o[k+1]))/I;y=Math.min(y,V),w=Math.min(w,B),x=Math.max(x,V),E=Math.max(E,B)}}return t[0]=Math.max(r[0],S(Math.max(y,r[0]))),t[1]=Math.max(r[1],S(Math.max(w,r[1]))),t[2]=Math.min(r[2],S(Math.min(x,r[2]))+64),t[3]=Math.min(r[3],S(Math.min(E,r[3]))+64),t[2]>t[0]&&t[3]>t[1]}level(e){let r=Math.sqrt(u(this.a,this.a))/this.resolution/u(this.g,this.forward),t=.5*e.width*Math.abs(e.clipFromEye[0])*r,o=0;for(;o<8&&2*t<=.75;++o)t*=2;return o}get pinholeStep(){let{zNear:e,zFar:r,planeZ:t}=this,o=Math.sqrt(u(this.a,this.a))/this.resolution/u(this.g,this.forward),i=65534*r*e/((r-e)*t*t);return Math.max(1,Math.min(65535,Math.ceil(3*t*o*i)))}coefficients(e){let{of:r,k1:t,k2:o,k3:i,resolution:n,zNear:s}=this,a=65534*this.zFar/(this.zFar-s),f=r.first,h=r.step;e[0]=n*(.5+t*f),e[1]=n*t*h,e[2]=n*(.5+o*f),e[3]=n*o*h,e[4]=1+i*f,e[5]=i*h,e[6]=n,e[7]=n*this.set.splat*r.splatScale,r.perspective?(e[8]=a*(1+(i+s)*f),e[9]=a*(i+s)*h,e[10]=e[4],e[11]=e[5]):(e[8]=a*(1/i+f-s),e[9]=a*h,e[10]=1/i+f,e[11]=h)}facing(e,r,t){let{of:o,origin:i,a:n,b:s,centre:a}=this;for(let l=0;l<o.hull.length;++l)if(!(o.hull[l][2]>=this.least))return-1;let f=0,h=0;for(let l=0;l<3;++l){let d=a[0]*n[l]+a[1]*s[l],m=o.perspective?i[l]-(this.g[l]+d)/a[2]:i[l]+d+a[2]*this.forward[l],g=(l===0?e:l===1?r:t)-m;f-=g*this.forward[l],h+=g*g}return 2+f/Math.sqrt(h)}along(e,r,t){let{set:{center:o},forward:i}=this;return i[0]*(o[0]-e)+i[1]*(o[1]-r)+i[2]*(o[2]-t)}isSure(e,r,t){if(this.of.perspective)return!1;let{set:{low:o,high:i},forward:n}=this,a=4*(.5*Math.hypot(i[0]-o[0],i[1]-o[1],i[2]-o[2]))/32767,f=n[0]*(this.origin[0]-e)+n[1]*(this.origin[1]-r)+n[2]*(this.origin[2]-t),h=-a;for(let l=0;l<3;++l){let d=l===0?e:l===1?r:t;h+=Math.min(n[l]*(o[l]-d),n[l]*(i[l]-d))}return f>a&&h>1.01*(f+a)/64}};var re=["warp","frame","order","limits","place","clip_from_local","forward_near","corner","right","down"],oe=new Uint32Array([65535,0,0,0]),ie=new Float32Array(4),se=new Float32Array([1]),Z=256,J=class{constructor(e,r,t,o){this.gl=e;this.decoder=t;this.host=o;this.stats={drawCalls:0,triangles:0,there:0};this.targets=[];this.depth=null;this.splatBuffer=null;this.width=0;this.height=0;this.clip=new Float32Array(16);this.coefficients=new Float32Array(12);this.shown=-1;this.result=null;this.level=0;this.wide=0;this.high=0;this.frame=0;this.best=-1;this.used=0;this.disposed=!1;this.slots=r.list.map(i=>({warp:new L(i,r),bytes:4*i.sheetWidth*i.sheetHeight+2*C*i.samples,coming:!1,failed:!1,lastUsed:0,next:null,stored:null})),this.splat=this.link("splats",O,H),this.pinhole=this.link("pinholes",P,j),this.halve=this.link("halves",P,q),this.board=this.link("relief",K,Y),this.noVertices=e.createVertexArray()}get bytes(){return this.used+16*this.width*this.height}get allFailed(){return this.slots.every(e=>e.failed)}get settled(){return this.best<0||this.slots[this.best].stored!==null||this.slots[this.best].failed}update(e,r,t){++this.frame,this.best=this.pick(e,r,t,!1),this.upload();let o=0;for(let i of this.slots)(i.coming||i.next)&&++o;this.best>=0&&this.want(this.best,!0);for(let i=0;i<this.slots.length&&o<1;++i)this.want(i,!1)&&++o}prepare(e){let{gl:r,stats:t,slots:o}=this,i=e.worldFromEye;if(t.drawCalls=t.triangles=0,this.shown=this.pick(i[12],i[13],i[14],!0),this.shown<0)return;let{warp:n,stored:s}=o[this.shown];if(o[this.shown].lastUsed=this.frame,!s||!n.place(i[12],i[13],i[14])||!n.show(e)){this.shown=-1;return}let a=Math.min(64,Math.ceil(.5*n.widest)+1),f=n.shown[0],h=n.shown[1];this.wide=n.shown[2]-f,this.high=n.shown[3]-h,this.makeTargets(this.wide+2*a,this.high+2*a),r.disable(r.SCISSOR_TEST),r.disable(r.BLEND),r.disable(r.STENCIL_TEST),r.disable(r.CULL_FACE),r.colorMask(!0,!0,!0,!0),this.drawSplats(n,s,f-a,h-a,this.wide+2*a,this.high+2*a),r.disable(r.DEPTH_TEST),r.bindVertexArray(this.noVertices),r.useProgram(this.pinhole.program),r.uniform4i(this.pinhole.at.place,a,a,n.pinholeStep,0),this.pass(0,1,this.wide,this.high),this.level=n.level(e);let l=1;for(let d=0;d<this.level;++d,l=1-l)r.useProgram(this.halve.program),r.uniform4i(this.halve.at.place,this.wide,this.high,0,0),this.wide=this.wide+1>>1,this.high=this.high+1>>1,this.pass(l,1-l,this.wide,this.high);r.bindVertexArray(null),this.result=this.targets[l]}draw(e,r){let{gl:t,stats:o,result:i}=this;if(this.shown<0||!i)return;let{warp:n}=this.slots[this.shown],{at:s,program:a}=this.board,f=e.worldFromEye,h=n.resolution,{a:l,b:d,g:m,forward:g,shown:F}=n;G(e,this.clip),t.useProgram(a),t.uniformMatrix4fv(s.clip_from_local,!1,this.clip),t.uniform4f(s.forward_near,-f[8],-f[9],-f[10],r);let y=F[0]/h,w=F[1]/h;t.uniform4f(s.corner,m[0]+y*l[0]+w*d[0],m[1]+y*l[1]+w*d[1],m[2]+y*l[2]+w*d[2],m[0]*g[0]+m[1]*g[1]+m[2]*g[2]);let x=(this.wide<<this.level)/h,E=(this.high<<this.level)/h;t.uniform4f(s.right,x*l[0],x*l[1],x*l[2],this.wide),t.uniform4f(s.down,E*d[0],E*d[1],E*d[2],this.high),t.uniform4f(s.place,this.wide,this.high,n.zNear,n.zFar),this.bind(i),t.bindVertexArray(this.noVertices),t.drawArrays(t.TRIANGLE_STRIP,0,4),t.bindVertexArray(null),++o.drawCalls,o.triangles+=2}dispose(){let{gl:e}=this;this.disposed=!0;for(let r of this.slots)r.next?.colors.close(),this.drop(r);this.dropTargets();for(let r of[this.splat,this.pinhole,this.halve,this.board])e.deleteProgram(r.program);e.deleteVertexArray(this.noVertices)}link(e,r,t){let{gl:o}=this,i=D(o,e,r,t);return o.useProgram(i),o.uniform1i(o.getUniformLocation(i,"codes"),1),{program:i,at:Object.fromEntries(re.map(n=>[n,o.getUniformLocation(i,n)]))}}pick(e,r,t,o){let i=-1,n=-1/0;for(let s=0;s<this.slots.length;++s){let{warp:a,stored:f,failed:h}=this.slots[s];if((o?!f:h)||!a.place(e,r,t))continue;let l=a.isSure(e,r,t),d=a.facing(e,r,t),m=l?8+a.along(e,r,t):d>=0?4+d:-s;m<=n||(n=m,i=s)}return i}want(e,r){let t=this.slots[e];if(t.stored||t.coming||t.failed||t.next)return!1;for(;this.used+t.bytes>this.host.budget;){let o=null;for(let i of this.slots)i.stored&&(!o||i.lastUsed<o.lastUsed)&&(o=i);if(!r)return!1;if(!o)break;this.drop(o)}return t.coming=!0,this.used+=t.bytes,this.load(e),!0}drop(e){let{gl:r}=this;e.stored&&(r.deleteVertexArray(e.stored.vertices),r.deleteBuffer(e.stored.buffer),r.deleteTexture(e.stored.sheet),e.stored=null,this.used-=e.bytes,--this.stats.there)}async load(e){let r=this.slots[e],{of:t}=r.warp,o=null;try{let i=Promise.all([t.layers,t.codes].map(a=>this.host.fetch(a))).then(async([a,f])=>this.decoder.samples(f,t.codes.name,t,await this.decoder.plane16(a,t.layers,U(t.width),U(t.height)))),n=this.host.fetch(t.colors).then(async a=>{o=await z(await this.decoder.check(a,t.colors),t.colors,t.sheetWidth,t.sheetHeight)}),[s]=await Promise.all([i,n]);if(this.disposed)throw new M("walk","was disposed of");r.next={samples:s,colors:o},this.host.arrived()}catch(i){if(o?.close(),this.disposed)return;r.failed=!0,this.used-=r.bytes,this.host.failed(N(i,`relief ${e}`))}finally{r.coming=!1}}upload(){let{gl:e}=this,r=0;for(;r<this.slots.length&&!this.slots[r].next;)++r;if(r===this.slots.length)return;let t=this.slots[r],{samples:o,colors:i}=t.next;t.next=null;let n=W(e,e.RGBA8,i.width,i.height);e.pixelStorei(e.UNPACK_FLIP_Y_WEBGL,!1),e.pixelStorei(e.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),e.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,e.NONE),e.texSubImage2D(e.TEXTURE_2D,0,0,0,e.RGBA,e.UNSIGNED_BYTE,i),e.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,e.BROWSER_DEFAULT_WEBGL),e.bindTexture(e.TEXTURE_2D,null),i.close();let s=e.createVertexArray(),a=e.createBuffer();e.bindVertexArray(s),e.bindBuffer(e.ARRAY_BUFFER,a),e.bufferData(e.ARRAY_BUFFER,o,e.STATIC_DRAW);for(let[f,h,l]of[[0,4,0],[1,2,4]])e.enableVertexAttribArray(f),e.vertexAttribIPointer(f,h,e.UNSIGNED_SHORT,2*C,2*l);e.bindVertexArray(null),t.stored={vertices:s,buffer:a,sheet:n},++this.stats.there,this.host.loaded(r)}drawSplats(e,r,t,o,i,n){let{gl:s,stats:a}=this,{of:f,k1:h,k2:l,k3:d}=e,{at:m}=this.splat;s.bindFramebuffer(s.FRAMEBUFFER,this.splatBuffer),s.viewport(0,0,i,n),s.enable(s.DEPTH_TEST),s.depthFunc(s.LESS),s.depthMask(!0),s.clearBufferfv(s.COLOR,0,ie),s.clearBufferuiv(s.COLOR,1,oe),s.clearBufferfv(s.DEPTH,0,se),s.useProgram(this.splat.program),e.coefficients(this.coefficients),s.uniform4fv(m.warp,this.coefficients),s.uniform4f(m.frame,t,o,i,n);let g=Math.max(f.width,f.height)+2,F=Math.max(-1,Math.min(f.width,Math.floor(h/d))),y=Math.max(-1,Math.min(f.height,Math.floor(l/d)));s.uniform4i(m.order,F,y,g,d<0?1:0),s.uniform2i(m.limits,e.leastCode,Math.max(1,Math.min(64,Math.floor(1048576e3/((g+1)*g))))),s.activeTexture(s.TEXTURE0),s.bindTexture(s.TEXTURE_2D,r.sheet),s.bindVertexArray(r.vertices),s.drawArrays(s.POINTS,0,f.samples),++a.drawCalls,a.triangles+=f.samples}bind(e){let{gl:r}=this;r.activeTexture(r.TEXTURE1),r.bindTexture(r.TEXTURE_2D,e.code),r.activeTexture(r.TEXTURE0),r.bindTexture(r.TEXTURE_2D,e.color)}pass(e,r,t,o){let{gl:i}=this;i.bindFramebuffer(i.FRAMEBUFFER,this.targets[r].framebuffer),i.viewport(0,0,t,o),this.bind(this.targets[e]),i.drawArrays(i.TRIANGLES,0,3),++this.stats.drawCalls,++this.stats.triangles}makeTargets(e,r){if(e<=this.width&&r<=this.height)return;let{gl:t}=this,o=(s,a)=>Math.max(a,Math.ceil(s/Z)*Z),i=o(e,this.width),n=o(r,this.height);this.dropTargets();for(let s=0;s<2;++s){let a=W(t,t.RGBA8,i,n,t.LINEAR),f=W(t,t.R16UI,i,n);this.targets.push({color:a,code:f,framebuffer:this.framebuffer(a,f)})}this.splatBuffer=this.framebuffer(this.targets[0].color,this.targets[0].code),this.depth=t.createRenderbuffer(),t.bindRenderbuffer(t.RENDERBUFFER,this.depth),t.renderbufferStorage(t.RENDERBUFFER,t.DEPTH_COMPONENT32F,i,n),t.framebufferRenderbuffer(t.FRAMEBUFFER,t.DEPTH_ATTACHMENT,t.RENDERBUFFER,this.depth),t.bindTexture(t.TEXTURE_2D,null),this.width=i,this.height=n}framebuffer(e,r){let{gl:t}=this,o=t.createFramebuffer();return t.bindFramebuffer(t.FRAMEBUFFER,o),t.framebufferTexture2D(t.FRAMEBUFFER,t.COLOR_ATTACHMENT0,t.TEXTURE_2D,e,0),t.framebufferTexture2D(t.FRAMEBUFFER,t.COLOR_ATTACHMENT1,t.TEXTURE_2D,r,0),t.drawBuffers([t.COLOR_ATTACHMENT0,t.COLOR_ATTACHMENT1]),o}dropTargets(){let{gl:e}=this;for(let r of this.targets)e.deleteTexture(r.color),e.deleteTexture(r.code),e.deleteFramebuffer(r.framebuffer);this.targets=[],this.result=null,e.deleteFramebuffer(this.splatBuffer),e.deleteRenderbuffer(this.depth),this.width=this.height=0}};function W(c,e,r,t,o=c.NEAREST){let i=c.createTexture();c.bindTexture(c.TEXTURE_2D,i),c.texStorage2D(c.TEXTURE_2D,1,e,r,t);for(let n of[c.TEXTURE_MIN_FILTER,c.TEXTURE_MAG_FILTER])c.texParameteri(c.TEXTURE_2D,n,o);return i}export{J as ReliefSet};
